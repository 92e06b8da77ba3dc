// Half of a mono-block sleeper, cut at the track's plane of symmetry: x in [-width/2, width/2], y in [0, length_y],
// z in [0, height], structured hexahedra with lines at the edges of the rail seat. Lengths in metres.
// Volume: concrete. Surfaces: bottom, top (without the rail seat), rail_seat, sides (both x faces), end (y = length_y),
// symmetry (y = 0).
DefineConstant[
  length_y = {1.30, Name "length_y"},
  width = {0.30, Name "width"},
  height = {0.22, Name "height"},
  seat_y = {0.75, Name "seat_y"},
  seat_length = {0.15, Name "seat_length"},
  cells_x = {6, Name "cells_x"},
  cells_y = {26, Name "cells_y"},
  cells_z = {4, Name "cells_z"}
];
If(length_y <= 0 || width <= 0 || height <= 0 || seat_length <= 0)
  Error("length_y, width, height and seat_length must be positive");
EndIf
If(seat_y - seat_length / 2 <= 0 || seat_y + seat_length / 2 >= length_y)
  Error("the rail seat, seat_y +- seat_length/2, must lie between 0 and length_y");
EndIf
If(cells_x < 1 || cells_x > 10000 || cells_x != Floor(cells_x) || cells_y < 3 || cells_y > 10000 || cells_y != Floor(cells_y) || cells_z < 1 || cells_z > 10000 || cells_z != Floor(cells_z))
  Error("cells_x and cells_z must be whole numbers from 1 to 10000, cells_y from 3");
EndIf

before = seat_y - seat_length / 2;
after = length_y - seat_y - seat_length / 2;
cells_seat = Round(cells_y * seat_length / length_y);
If(cells_seat < 1 || cells_seat > 10000 || cells_seat != Floor(cells_seat))
  cells_seat = 1;
EndIf
cells_before = Round((cells_y - cells_seat) * before / (before + after));
If(cells_before < 1 || cells_before > 10000 || cells_before != Floor(cells_before))
  cells_before = 1;
EndIf
If(cells_before > cells_y - cells_seat - 1)
  cells_before = cells_y - cells_seat - 1;
EndIf
cells_after = cells_y - cells_seat - cells_before;

Point(1) = {-width / 2, 0, 0};
Point(2) = {-width / 2, 0, height};
Point(3) = {width / 2, 0, height};
Point(4) = {width / 2, 0, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = cells_z + 1;
Transfinite Curve{2, 4} = cells_x + 1;
Transfinite Surface{1};
Recombine Surface{1};
inner[] = Extrude {0, before, 0} { Surface{1}; Layers{cells_before}; Recombine; };
seat[] = Extrude {0, seat_length, 0} { Surface{inner[0]}; Layers{cells_seat}; Recombine; };
outer[] = Extrude {0, after, 0} { Surface{seat[0]}; Layers{cells_after}; Recombine; };

Physical Volume("concrete") = {inner[1], seat[1], outer[1]};
Physical Surface("symmetry") = {1};
Physical Surface("end") = {outer[0]};
Physical Surface("sides") = {inner[2], seat[2], outer[2], inner[4], seat[4], outer[4]};
Physical Surface("top") = {inner[3], outer[3]};
Physical Surface("rail_seat") = {seat[3]};
Physical Surface("bottom") = {inner[5], seat[5], outer[5]};
