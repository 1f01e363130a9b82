%
; pocket
(MSG, part 2)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t1 m6 (tool 1: 6 mm)
g43 h1
s8000 m3 m8
g0 x20 y20
g0 z#<clearance>
f#<plunge>
g1 z-2 f100
g1 x22 y20 f500
g2 x18 y20 i-2 j0
g2 x22 y20 i2 j0
g1 x25 y20 f500
g2 x15 y20 i-5 j0
g2 x25 y20 i5 j0
g1 x28 y20 f500
g2 x12 y20 i-8 j0
g2 x28 y20 i8 j0
g1 x31 y20 f500
g2 x9 y20 i-11 j0
g2 x31 y20 i11 j0
g0 z15
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
