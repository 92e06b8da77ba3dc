// Quarter of a block with a rectangular patch at the middle of its top: x in [0, length_x/2], y in [0, length_y/2], top at
// z = 0, structured hexahedra that grow away from the patch. Lengths in metres. x = 0 and y = 0 are planes of symmetry.
// Volume: solid. Surfaces: mid_x, mid_y, far_x, far_y, base, patch, top (without the patch).
DefineConstant[
  length_x = {10.0, Name "length_x"},
  length_y = {6.0, Name "length_y"},
  depth = {3.0, Name "depth"},
  patch_x = {0.3, Name "patch_x"},
  patch_y = {0.3, Name "patch_y"},
  cells_patch = {6, Name "cells_patch"},
  cells_x = {14, Name "cells_x"},
  cells_y = {12, Name "cells_y"},
  cells_z = {18, Name "cells_z"},
  growth = {1.3, Name "growth"}
];
If(depth <= 0 || patch_x <= 0 || patch_y <= 0 || length_x <= patch_x || length_y <= patch_y)
  Error("depth, patch_x and patch_y must be positive, and the block larger than its patch");
EndIf
If(cells_patch < 1 || cells_patch > 10000 || cells_patch != Floor(cells_patch) || cells_x < 1 || cells_x > 10000 || cells_x != Floor(cells_x) || cells_y < 1 || cells_y > 10000 || cells_y != Floor(cells_y) || cells_z < 1 || cells_z > 10000 || cells_z != Floor(cells_z) || growth < 1)
  Error("cells_patch, cells_x, cells_y and cells_z must be whole numbers from 1 to 10000, growth at least 1");
EndIf

Point(1) = {0, 0, 0};
Point(2) = {patch_x / 2, 0, 0};
Point(3) = {length_x / 2, 0, 0};
Point(4) = {0, patch_y / 2, 0};
Point(5) = {patch_x / 2, patch_y / 2, 0};
Point(6) = {length_x / 2, patch_y / 2, 0};
Point(7) = {0, length_y / 2, 0};
Point(8) = {patch_x / 2, length_y / 2, 0};
Point(9) = {length_x / 2, length_y / 2, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {4, 5};
Line(4) = {5, 6};
Line(5) = {7, 8};
Line(6) = {8, 9};
Line(7) = {1, 4};
Line(8) = {4, 7};
Line(9) = {2, 5};
Line(10) = {5, 8};
Line(11) = {3, 6};
Line(12) = {6, 9};
Curve Loop(1) = {1, 9, -3, -7};
Plane Surface(1) = {1};
Curve Loop(2) = {2, 11, -4, -9};
Plane Surface(2) = {2};
Curve Loop(3) = {3, 10, -5, -8};
Plane Surface(3) = {3};
Curve Loop(4) = {4, 12, -6, -10};
Plane Surface(4) = {4};
Transfinite Curve{1, 3, 5, 7, 9, 11} = cells_patch + 1;
Transfinite Curve{2, 4, 6} = cells_x + 1 Using Progression growth;
Transfinite Curve{8, 10, 12} = cells_y + 1 Using Progression growth;
Transfinite Surface{1, 2, 3, 4};
Recombine Surface{1, 2, 3, 4};

// layers of thickness first, first growth, first growth^2 ... that fill the depth
total = 0;
For i In {0 : cells_z - 1}
  total += growth^i;
EndFor
reached = 0;
For i In {0 : cells_z - 1}
  reached += growth^i / total;
  counts[i] = 1;
  depths[i] = reached;
EndFor
a[] = Extrude {0, 0, -depth} { Surface{1}; Layers{counts[], depths[]}; Recombine; };
b[] = Extrude {0, 0, -depth} { Surface{2}; Layers{counts[], depths[]}; Recombine; };
c[] = Extrude {0, 0, -depth} { Surface{3}; Layers{counts[], depths[]}; Recombine; };
d[] = Extrude {0, 0, -depth} { Surface{4}; Layers{counts[], depths[]}; Recombine; };

Physical Volume("solid") = {a[1], b[1], c[1], d[1]};
Physical Surface("patch") = {1};
Physical Surface("top") = {2, 3, 4};
Physical Surface("base") = {a[0], b[0], c[0], d[0]};
Physical Surface("mid_y") = {a[2], b[2]};
Physical Surface("mid_x") = {a[5], c[5]};
Physical Surface("far_x") = {b[3], d[3]};
Physical Surface("far_y") = {c[4], d[4]};
