// Box of structured hexahedra: x from 0 to length, centred on y = z = 0. Lengths in metres.
// Volume: solid. Surfaces: x_min, x_max, y_min, y_max, z_min, z_max.
DefineConstant[
  length = {2.4, Name "length"},
  width = {0.25, Name "width"},
  height = {0.22, Name "height"},
  cells_x = {48, Name "cells_x"},
  cells_y = {4, Name "cells_y"},
  cells_z = {4, Name "cells_z"}
];
If(length <= 0 || width <= 0 || height <= 0)
  Error("length, width and height must be positive");
EndIf
If(cells_x < 1 || cells_x > 10000 || cells_x != Floor(cells_x) || cells_y < 1 || cells_y > 10000 || cells_y != Floor(cells_y) || cells_z < 1 || cells_z > 10000 || cells_z != Floor(cells_z))
  Error("cells_x, cells_y and cells_z must be whole numbers from 1 to 10000");
EndIf

Point(1) = {0, -width / 2, -height / 2};
Point(2) = {length, -width / 2, -height / 2};
Point(3) = {length, width / 2, -height / 2};
Point(4) = {0, width / 2, -height / 2};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = cells_x + 1;
Transfinite Curve{2, 4} = cells_y + 1;
Transfinite Surface{1};
Recombine Surface{1};
box[] = Extrude {0, 0, height} { Surface{1}; Layers{cells_z}; Recombine; };

Physical Volume("solid") = {box[1]};
Physical Surface("z_min") = {1};
Physical Surface("z_max") = {box[0]};
Physical Surface("y_min") = {box[2]};
Physical Surface("x_max") = {box[3]};
Physical Surface("y_max") = {box[4]};
Physical Surface("x_min") = {box[5]};
