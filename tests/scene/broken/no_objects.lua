-- expect: :1: expected at least one object
scene {}
