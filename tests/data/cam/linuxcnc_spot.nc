%
; spot
(MSG, part 5)
#<clearance> = 25.000
#<plunge> = 120 ; mm/min
g21 g17 g90 g40 g49 g80 g94 g91.1
g64 p0.005 q0.005
g54
t2 m6 (tool 2: 3 mm)
g43 h2
s3000 m3 m8
g0 x10 y10
g0 z#<clearance>
f#<plunge>
g98
g82 x10 y10 z-12 r2 p0.2 f80
x50 y10
x50 y30
x10 y30
g80
g0 z[#<clearance> + 5]
m5 m9
g53 g0 z0
m2
%
