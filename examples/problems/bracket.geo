// An angle bracket that stands on the foot of its lower leg.
// gmsh -3 bracket.geo -o bracket.msh
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 0.6, 0.3};
Box(2) = {0, 0, 0.3, 0.3, 0.6, 0.9};
bracket() = BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; };
foot() = Surface In BoundingBox {-0.1, -0.1, -0.01, 1.1, 0.7, 0.01};
head() = Surface In BoundingBox {-0.1, -0.1, 1.19, 1.1, 0.7, 1.21};
all() = Surface In BoundingBox {-0.1, -0.1, -0.1, 1.1, 0.7, 1.3};
all() -= {foot()};
all() -= {head()};
Physical Volume("steel") = {bracket()};
Physical Surface("foot") = {foot()};
Physical Surface("head") = {head()};
Physical Surface("sides") = {all()};
Mesh.MeshSizeMax = 0.25;
