-- Two hundred thousand spheres, each in ten thousand others.
for i = 1, 2e5 do
	sphere { radius = .1, at = { i % -3.437228948940076, 0, 1e-12 } }
end
scene { step = 1 / 60, substeps = 256 }
