// Sides of a box, each of one quadrilateral that faces inwards; x from 0 to length, y from 0 to width, z from 0 to
// height. floor = 1: with a floor. rim_before, rim_behind: level plates outside the box at z = rim_level, at x < 0 and
// at x > length, as long as said, which close the gap when one half of a shear box slides over the other.
// Lengths in metres.
DefineConstant[
  length = {0.3, Name "length"},
  width = {0.3, Name "width"},
  height = {0.1, Name "height"},
  floor = {0, Name "floor"},
  rim_before = {0, Name "rim_before"},
  rim_behind = {0, Name "rim_behind"},
  rim_level = {0, Name "rim_level"},
  rim_faces_up = {1, Name "rim_faces_up"}
];
If(length <= 0 || width <= 0 || height <= 0 || rim_before < 0 || rim_behind < 0)
  Error("length, width and height must be positive, the rims not negative");
EndIf

Point(1) = {0, 0, 0};
Point(2) = {length, 0, 0};
Point(3) = {length, width, 0};
Point(4) = {0, width, 0};
For k In {1:4}
  Point(4 + k) = {(k == 2 || k == 3) * length, (k > 2) * width, height};
EndFor
For k In {1:4}
  Line(k) = {k, (k % 4) + 1};
  Line(10 + k) = {4 + k, 4 + (k % 4) + 1};
  Line(20 + k) = {k, 4 + k};
EndFor
For k In {1:4}
  Curve Loop(k) = {20 + k, 10 + k, -(20 + (k % 4) + 1), -k};
  Plane Surface(k) = {k};
EndFor
walls[] = {1:4};
If(floor == 1)
  Curve Loop(5) = {1:4};
  Plane Surface(5) = {5};
  walls[] += {5};
EndIf
ends[] = {-rim_before, 0, length, length + rim_behind};
For side In {0:1}
  If(ends[2 * side + 1] > ends[2 * side])
    first = 100 * (side + 1);
    For k In {1:4}
      Point(first + k) = {ends[2 * side + (k == 2 || k == 3)], (k > 2) * width, rim_level};
    EndFor
    For k In {1:4}
      Line(first + k) = {first + k, first + (k % 4) + 1};
    EndFor
    If(rim_faces_up == 1)
      Curve Loop(first) = {first + 1, first + 2, first + 3, first + 4};
    Else
      Curve Loop(first) = {-(first + 4), -(first + 3), -(first + 2), -(first + 1)};
    EndIf
    Plane Surface(first) = {first};
    walls[] += {first};
  EndIf
EndFor
Transfinite Curve{:} = 2;
Transfinite Surface{:};
Recombine Surface{:};
Physical Surface("walls") = {walls[]};
