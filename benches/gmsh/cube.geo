// The cube (-1.5, 1.5)^3 of the scene radial-3d; `gmsh -setnumber size 0.055 -3 cube.geo`
SetFactory("OpenCASCADE");
DefineConstant[ size = 0.055 ];
Box(1) = {-1.5, -1.5, -1.5, 3, 3, 3};
MeshSize{ PointsOf{ Volume{1}; } } = size;
Physical Surface("dirichlet") = {1, 2, 3, 4, 5, 6};
Physical Volume("domain") = {1};
