-- expect: :2: tabel: unknown name
local t = tabel
