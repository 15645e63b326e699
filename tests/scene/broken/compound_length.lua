-- expect: compound.parts[1].shape: expected "capsule" or "cylinder" with a length
compound { parts = { { radius = 1, length = 1 } } }
