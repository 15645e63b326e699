-- expect: :3: bax: unknown name, did you mean box?
ground {}
bax { size = { 1, 1, 1 } }
