-- expect: :3: material "wood": exists already
material "wood" {}
material "wood" {}
