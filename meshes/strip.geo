// Quarter of a strip on two ledges: x in [0, length/2], y in [0, width/2], z in [-height/2, height/2], structured
// hexahedra. Lengths in metres. The planes x = 0 and y = 0 are the strip's planes of symmetry.
// Volume: solid. Surfaces: mid_x (x = 0), mid_y (y = 0), top, ledge (bottom from x = span/2 on), bottom (the rest).
DefineConstant[
  length = {8.0, Name "length"},
  span = {6.0, Name "span"},
  width = {1.0, Name "width"},
  height = {0.1, Name "height"},
  cells_span = {240, Name "cells_span"},
  cells_ledge = {40, Name "cells_ledge"},
  cells_y = {4, Name "cells_y"},
  cells_z = {8, Name "cells_z"}
];
If(span <= 0 || length <= span || width <= 0 || height <= 0)
  Error("span, width and height must be positive, and the length larger than the span");
EndIf
If(cells_span < 1 || cells_span > 10000 || cells_span != Floor(cells_span) || cells_ledge < 1 || cells_ledge > 10000 || cells_ledge != Floor(cells_ledge) || cells_y < 1 || cells_y > 10000 || cells_y != Floor(cells_y) || cells_z < 1 || cells_z > 10000 || cells_z != Floor(cells_z))
  Error("cells_span, cells_ledge, cells_y and cells_z must be whole numbers from 1 to 10000");
EndIf

Point(1) = {0, 0, -height / 2};
Point(2) = {0, width / 2, -height / 2};
Point(3) = {0, width / 2, height / 2};
Point(4) = {0, 0, height / 2};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = cells_y + 1;
Transfinite Curve{2, 4} = cells_z + 1;
Transfinite Surface{1};
Recombine Surface{1};
inner[] = Extrude {span / 2, 0, 0} { Surface{1}; Layers{cells_span}; Recombine; };
outer[] = Extrude {(length - span) / 2, 0, 0} { Surface{inner[0]}; Layers{cells_ledge}; Recombine; };

Physical Volume("solid") = {inner[1], outer[1]};
Physical Surface("mid_x") = {1};
Physical Surface("bottom") = {inner[2]};
Physical Surface("ledge") = {outer[2]};
Physical Surface("top") = {inner[4], outer[4]};
Physical Surface("mid_y") = {inner[5], outer[5]};
