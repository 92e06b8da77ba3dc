// Formation on subgrade: x in [0, length_x], y in [0, length_y], top at z = 0, structured hexahedra whose nodes the two
// layers share. Lengths in metres.
// Volumes: formation, subgrade. Surfaces: top, base, cut_x (both x faces), cut_y0 (y = 0), cut_y1 (y = length_y).
DefineConstant[
  length_x = {0.60, Name "length_x"},
  length_y = {2.50, Name "length_y"},
  formation_height = {0.30, Name "formation_height"},
  subgrade_height = {0.70, Name "subgrade_height"},
  cells_x = {6, Name "cells_x"},
  cells_y = {25, Name "cells_y"},
  cells_formation = {3, Name "cells_formation"},
  cells_subgrade = {7, Name "cells_subgrade"}
];
If(length_x <= 0 || length_y <= 0 || formation_height <= 0 || subgrade_height <= 0)
  Error("length_x, length_y, formation_height and subgrade_height must be positive");
EndIf
If(cells_x < 1 || cells_x > 10000 || cells_x != Floor(cells_x) || cells_y < 1 || cells_y > 10000 || cells_y != Floor(cells_y) || cells_formation < 1 || cells_formation > 10000 || cells_formation != Floor(cells_formation) || cells_subgrade < 1 || cells_subgrade > 10000 || cells_subgrade != Floor(cells_subgrade))
  Error("cells_x, cells_y, cells_formation and cells_subgrade must be whole numbers from 1 to 10000");
EndIf

depth = formation_height + subgrade_height;
Point(1) = {0, 0, -depth};
Point(2) = {length_x, 0, -depth};
Point(3) = {length_x, length_y, -depth};
Point(4) = {0, length_y, -depth};
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
subgrade[] = Extrude {0, 0, subgrade_height} { Surface{1}; Layers{cells_subgrade}; Recombine; };
formation[] = Extrude {0, 0, formation_height} { Surface{subgrade[0]}; Layers{cells_formation}; Recombine; };

Physical Volume("subgrade") = {subgrade[1]};
Physical Volume("formation") = {formation[1]};
Physical Surface("base") = {1};
Physical Surface("top") = {formation[0]};
Physical Surface("cut_y0") = {subgrade[2], formation[2]};
Physical Surface("cut_x") = {subgrade[3], formation[3], subgrade[5], formation[5]};
Physical Surface("cut_y1") = {subgrade[4], formation[4]};
