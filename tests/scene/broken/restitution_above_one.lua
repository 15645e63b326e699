-- expect: :2: material "rubber".restitution: expected a number from 0 to 1, got 1.2
material "rubber" { restitution = 1.2 }
