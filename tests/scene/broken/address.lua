-- expect: :2: string.format: %p is an address
local where = ("%-9p"):format({})
sphere { radius = 1 }
