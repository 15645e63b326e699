"""Greedy visitors end no run: in scenes with scripts, FMUs aside, joints, terrain and compounds, by each role. Without arguments
in all installed scenes; with names of scenes only there, and by a few kinds of objects."""

import os
import sys
import unittest

import greedy
import program

NAMED = sys.argv[1:]


class Visits(program.Case):
	def test_visits(self):
		for name in NAMED or sorted(file.removesuffix(".lua") for file in os.listdir(program.SCENES) if file.endswith(".lua")):
			with self.subTest(scene=name):
				visit = greedy.Visit(program.scene(name), "--set", "patience=600", objects=greedy.piles() if NAMED else None)
				self.assertTrue(visit.alive and visit.code == 0, visit.err[-3:])
				self.assertGreater(visit.sent, 100)
				self.assertTrue(visit.waits) # the innocent visitor was there
				for line in visit.err:
					if "restarting all" in line and "was killed by" not in line:
						self.assertIn("; frozen: object ", line)


unittest.main(argv=sys.argv[:1])
