// The square (-1.5, 1.5)^2 of the scene radial-2d; `gmsh -setnumber size 0.0045 -2 square.geo`
DefineConstant[ size = 0.0045 ];
Point(1) = {-1.5, -1.5, 0, size};
Point(2) = {1.5, -1.5, 0, size};
Point(3) = {1.5, 1.5, 0, size};
Point(4) = {-1.5, 1.5, 0, size};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Curve("dirichlet") = {1, 2, 3, 4};
Physical Surface("domain") = {1};
