-- expect: :2: require: not available in scenes, which reach no files, no system and no other code
require("os")
