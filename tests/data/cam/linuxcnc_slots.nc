%
; slots
(MSG, part 11)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t1 m6 (tool 1: 6 mm)
g43 h1
s8000 m3 m8
g0 x10 y10
g0 z#<clearance>
f#<plunge>
g0 x10 y10
g0 z1
g1 x30 y10 z-1 f150
g1 x10 y10 f400
g1 x30 y10 z-2 f150
g1 x10 y10 f400
g1 x30 y10 z-3 f150
g1 x10 y10 f400
g0 z15
g0 x10 y20
g0 z1
g1 x30 y20 z-1 f150
g1 x10 y20 f400
g1 x30 y20 z-2 f150
g1 x10 y20 f400
g1 x30 y20 z-3 f150
g1 x10 y20 f400
g0 z15
g0 x10 y30
g0 z1
g1 x30 y30 z-1 f150
g1 x10 y30 f400
g1 x30 y30 z-2 f150
g1 x10 y30 f400
g1 x30 y30 z-3 f150
g1 x10 y30 f400
g0 z15
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
