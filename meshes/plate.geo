// Rectangle in the plane z = 0 about the origin, of one quadrilateral that faces down. Lengths in metres.
DefineConstant[
  length = {0.3, Name "length"},
  width = {0.3, Name "width"}
];
If(length <= 0 || width <= 0)
  Error("length and width must be positive");
EndIf

Point(1) = {-length / 2, -width / 2, 0};
Point(2) = {-length / 2, width / 2, 0};
Point(3) = {length / 2, width / 2, 0};
Point(4) = {length / 2, -width / 2, 0};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Transfinite Curve{:} = 2;
Transfinite Surface{1};
Recombine Surface{1};
Physical Surface("plate") = {1};
