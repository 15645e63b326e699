-- expect: :2: package: not available in scenes, which reach no files, no system and no other code
package.loadlib("libc.so.6", "system")
