// A plate with a bore and an elliptic inclusion.
// gmsh -2 plate.geo -o plate.msh
SetFactory("OpenCASCADE");
Rectangle(1) = {-2, -1, 0, 4, 2};
Disk(2) = {-1, 0, 0, 0.4};
Disk(3) = {0.8, 0, 0, 0.7, 0.45};
plate() = BooleanDifference{ Surface{1}; Delete; }{ Surface{2}; Delete; };
parts() = BooleanFragments{ Surface{plate()}; Delete; }{ Surface{3}; Delete; };
bore() = Curve In BoundingBox {-1.5, -0.5, -0.1, -0.5, 0.5, 0.1};
inclusion() = Surface In BoundingBox {0, -0.6, -0.1, 1.6, 0.6, 0.1};
all() = Surface In BoundingBox {-2.1, -1.1, -0.1, 2.1, 1.1, 0.1};
left() = Curve In BoundingBox {-2.1, -1.1, -0.1, -1.9, 1.1, 0.1};
right() = Curve In BoundingBox {1.9, -1.1, -0.1, 2.1, 1.1, 0.1};
bottom() = Curve In BoundingBox {-2.1, -1.1, -0.1, 2.1, -0.9, 0.1};
top() = Curve In BoundingBox {-2.1, 0.9, -0.1, 2.1, 1.1, 0.1};
Physical Surface("inclusion") = {inclusion()};
all() -= {inclusion()};
Physical Surface("matrix") = {all()};
Physical Curve("bore") = {bore()};
Physical Curve("ends") = {left(), right()};
Physical Curve("edges") = {bottom(), top()};
Mesh.MeshSizeMax = 0.3;
Mesh.MeshSizeFromCurvature = 12;
