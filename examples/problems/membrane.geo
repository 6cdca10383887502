// An elliptic membrane.
// gmsh -2 membrane.geo -o membrane.msh
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 1.5, 1};
Physical Surface("membrane") = {1};
Physical Curve("rim") = {1};
Mesh.MeshSizeMax = 0.3;
