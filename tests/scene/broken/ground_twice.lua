-- expect: :3: ground.name: expected a name of its own, got "ground" as in line 2
ground {}
ground {}
