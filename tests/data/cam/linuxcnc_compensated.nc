%
; compensated
(MSG, part 9)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t1 m6 (tool 1: 6 mm)
g43 h1
s8000 m3 m8
g0 x30 y-20
g0 z#<clearance>
f#<plunge>
g1 z-2 f120
g42 d1
g1 x30 y0 f500
g1 x55 y0 f500
g3 x60 y5 i0 j5
g1 x60 y35
g3 x55 y40 i-5 j0
g1 x5 y40
g3 x0 y35 i0 j-5
g1 x0 y5
g3 x5 y0 i5 j0
g1 x30 y0
g40
g1 x30 y-20
g0 z15
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
