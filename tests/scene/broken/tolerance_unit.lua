-- expect: :2: scene.tolerance: expected a length, as .5mm or .0005 (m), or a share above 0%, up to 100%, as .1%, got "1 inch"
scene { tolerance = '1 inch' }
