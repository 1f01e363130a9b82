%
; contour
(MSG, part 0)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t1 m6 (tool 1: 6 mm)
g43 h1
s8000 m3 m8
g0 x30 y-3
g0 z#<clearance>
f#<plunge>
g1 z-1.5 f120
g1 x57 y-3 f600
g3 x63 y3 i0 j6
g1 x63 y37
g3 x57 y43 i-6 j0
g1 x3 y43
g3 x-3 y37 i0 j-6
g1 x-3 y3
g3 x3 y-3 i6 j0
g1 x30 y-3
g1 z-3 f120
g1 x57 y-3 f600
g3 x63 y3 i0 j6
g1 x63 y37
g3 x57 y43 i-6 j0
g1 x3 y43
g3 x-3 y37 i0 j-6
g1 x-3 y3
g3 x3 y-3 i6 j0
g1 x30 y-3
g0 z15
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
