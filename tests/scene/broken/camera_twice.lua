-- expect: :3: camera "main": exists already
camera "main" {}
camera "main" {}
