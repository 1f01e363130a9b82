%
; helix
(MSG, part 3)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t1 m6 (tool 1: 6 mm)
g43 h1
s8000 m3 m8
g0 x14 y20
g0 z#<clearance>
f#<plunge>
g0 z1
g3 x26 y20 z0.5 i6 j0 f300
g3 x14 y20 z0 i-6 j0 f300
g3 x26 y20 z-0.5 i6 j0 f300
g3 x14 y20 z-1 i-6 j0 f300
g3 x26 y20 z-1.5 i6 j0 f300
g3 x14 y20 z-2 i-6 j0 f300
g3 x26 y20 z-2.5 i6 j0 f300
g3 x14 y20 z-3 i-6 j0 f300
g3 x26 y20 z-3.5 i6 j0 f300
g3 x14 y20 z-4 i-6 j0 f300
g3 x26 y20 z-4.5 i6 j0 f300
g3 x14 y20 z-5 i-6 j0 f300
g0 z15
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
