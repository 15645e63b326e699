-- expect: :2: bare
error("bare", 0)
