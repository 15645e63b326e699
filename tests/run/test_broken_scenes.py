"""Broken scenes: one line with the place, exit code 2, and nothing left behind, neither memory nor files."""

import os
import unittest

import program

SCENES = {
	"syntax": ("scene { title = 'x' \nbox {", ":"),
	"type": ("ground {}\nbox { size = 'large' }", ":2:"),
	"unknown pattern": ("box { size = { 1, 1, 1 }, pattern = 'tile' }", "box.pattern: expected"),
	"pattern of a sphere": ("sphere { radius = 1, pattern = 'tiles' }", "sphere.pattern: expected with a box"),
	"unknown field": ("box { sizze = { 1, 1, 1 } }", "size"),
	"negative size": ("box { size = { 1, -1, 1 }, at = { 0, 0, 1 }, mass = 1 }", ":1:"),
	"nan": ("box { size = { 1, 1, 1 }, at = { 0, 0/0, 1 }, mass = 1 }", ":1:"),
	"infinite": ("box { size = { 1, 1, 1 }, at = { 0, 1/0, 1 }, mass = 1 }", ":1:"),
	"no mass": ("box { size = { 1, 1, 1 }, at = { 0, 0, 1 }, mass = 0 }", "mass"),
	"endless": ("while true do end", ":"),
	"memory": ("local t = {} for i = 1, 1e9 do t[i] = ('x'):rep(1e6) .. i end", ":"),
	"recursion": ("local function f() return f() + 1 end f()", ":"),
	"files": ("io.open('/etc/passwd')", "io"),
	"system": ("os.execute('true')", "os"),
	"require": ("require 'posix'", "require"),
	"bytecode": ("load('\\27Lua')()", ":"),
	"error": ("error('no')", "no"),
	"nothing": ("", "."),
	"binary": ("\x1bLua\x54\x00", "."),
}


class Broken(program.Case):
	def test_each(self):
		name = "broken-%d" % os.getpid() # other tests may be running
		for what, (text, saying) in SCENES.items():
			with self.subTest(what):
				path = self.path("broken.lua")
				with open(path, "w") as f:
					f.write(text)
				done = self.refuse("run", path, "--name", name, "--json", "out.json", "--out", "frames", saying=saying)
				self.assertIn("broken.lua", done.stderr)
				os.remove(path)
				self.assertEqual(os.listdir(self.directory.name), [])
				self.assertFalse(os.path.exists(program.segment(name)))


unittest.main()
