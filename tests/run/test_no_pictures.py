"""A computer that cannot draw: frames are refused with a reason, and all else works."""

import os
import unittest

import program

# An EGL without a vendor's library, as on a server without one
BLIND = {**os.environ, "__EGL_VENDOR_LIBRARY_FILENAMES": "/dev/null", "__EGL_VENDOR_LIBRARY_DIRS": "/dev/null"}


class NoPictures(program.Case):
	def test_frames_refused(self):
		done = program.call("run", program.scene("stack"), "--duration", ".1", "--out", self.path("f"), "--name", self.name,
			env=BLIND)
		self.assertEqual(done.returncode, 1)
		self.assertIn("EGL", done.stderr)
		self.assertFalse(os.path.exists(self.path("f")))

	def test_all_else_works(self):
		r = program.report(program.scene("stack"), "--duration", ".1", "--record", self.path("r.h5"), env=BLIND)
		self.assertEqual(r["outcome"], "finished")
		with open(self.path("r.h5"), "rb") as f:
			self.assertEqual(f.read(8), b"\x89HDF\r\n\x1a\n")


unittest.main()
