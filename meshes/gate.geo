// Upright rectangle in the plane x = 0, of one quadrilateral that faces towards -x: y from 0 to width, z from 0 to height.
// Lengths in metres.
DefineConstant[
  width = {0.3, Name "width"},
  height = {1.0, Name "height"}
];
If(width <= 0 || height <= 0)
  Error("width and height must be positive");
EndIf

Point(1) = {0, 0, 0};
Point(2) = {0, 0, height};
Point(3) = {0, width, height};
Point(4) = {0, width, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{1, 2, 3, 4} = 2;
Transfinite Surface{1};
Recombine Surface{1};
Physical Surface("gate") = {1};
