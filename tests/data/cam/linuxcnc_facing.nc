%
; facing
(MSG, part 1)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t1 m6 (tool 1: 6 mm)
g43 h1
s8000 m3 m8
g0 x-5 y0
g0 z#<clearance>
f#<plunge>
g1 z-0.5 f200
g1 x65 f900
g1 y5 f900
g1 x-5 f900
g1 y10 f900
g1 x65 f900
g1 y15 f900
g1 x-5 f900
g1 y20 f900
g1 x65 f900
g1 y25 f900
g1 x-5 f900
g1 y30 f900
g1 x65 f900
g1 y35 f900
g1 x-5 f900
g1 y40 f900
g0 z15
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
