// Square hopper: a bin with vertical sides over a funnel of straight sides; open above and below. The axis is z at
// x = y = 0, the aperture lies at z = 0. Lengths in metres. Facets face inwards: for grains inside (one-sided wall).
DefineConstant[
  aperture = {0.25, Name "aperture"},
  width = {0.75, Name "width"},
  funnel = {0.25, Name "funnel"},
  bin = {1.0, Name "bin"}
];
If(aperture <= 0 || width <= aperture || funnel <= 0 || bin <= 0)
  Error("aperture, funnel and bin must be positive, width larger than aperture");
EndIf

half[] = {aperture / 2, width / 2, width / 2};
level[] = {0, funnel, funnel + bin};
For ring In {0:2}
  Point(4 * ring + 1) = {-half[ring], -half[ring], level[ring]};
  Point(4 * ring + 2) = {half[ring], -half[ring], level[ring]};
  Point(4 * ring + 3) = {half[ring], half[ring], level[ring]};
  Point(4 * ring + 4) = {-half[ring], half[ring], level[ring]};
  For k In {1:4}
    Line(10 * ring + k) = {4 * ring + k, 4 * ring + (k % 4) + 1};
    If(ring > 0)
      Line(100 * ring + k) = {4 * ring + k - 4, 4 * ring + k};
    EndIf
  EndFor
EndFor
For ring In {1:2}
  For k In {1:4}
    Curve Loop(10 * ring + k) = {100 * ring + k, 10 * ring + k, -(100 * ring + (k % 4) + 1), -(10 * (ring - 1) + k)};
    Plane Surface(10 * ring + k) = {10 * ring + k};
  EndFor
EndFor
Transfinite Curve{:} = 2;
Transfinite Surface{:};
Recombine Surface{:};
Physical Surface("hopper") = {11:14, 21:24};
