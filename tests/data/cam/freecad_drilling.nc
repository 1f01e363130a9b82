(Exported by FreeCAD)
(Post Processor: linuxcnc_post)
(Output Time:2024-01-05 10:00:00.000000)
(begin preamble)
G17 G54 G40 G49 G80 G90
G21
(begin operation: Fixture)
(machine units: mm/min)
G54
(finish operation: Fixture)
(begin operation: drilling)
(TC: 3mm Endmill)
M5
M6 T2
G43 H2
M3 S3000
(Coolant On:flood)
M8
G0 Z25.000
G0 X10.000 Y10.000
G98
G81 X10.000 Y10.000 Z-12.000 R2.000 F80.000
G81 X50.000 Y10.000 Z-12.000 R2.000 F80.000
G81 X50.000 Y30.000 Z-12.000 R2.000 F80.000
G81 X10.000 Y30.000 Z-12.000 R2.000 F80.000
G80
M9
G0 Z25.000
(begin postamble)
M05
G17 G54 G90 G80 G40
M2
