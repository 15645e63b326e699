-- expect: :4: unexpected symbol near '}'
ground {}
box {
  size = }
