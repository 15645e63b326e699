"""The package as others take it: documentation of all of it, types that mypy accepts, and a wheel made of a checkout."""
import importlib.util
import inspect
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

try:
    import gymnasium # pylint: disable=unused-import # obsim.gym needs it
except ImportError:
    import gymnasium_stand_in # pylint: disable=unused-import # installs itself

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODULES = ['obsim', *('obsim.' + p.stem for p in (ROOT / 'python/obsim').glob('*.py') if p.stem[0] != '_')]


def said(*words, **how):
    """What a command prints, and its exit code."""
    done = subprocess.run(words, capture_output=True, text=True, check=False, **how)
    return done.returncode, done.stdout + done.stderr


class Package(unittest.TestCase):
    def test_documented(self):
        missing = []
        for name in MODULES:
            module = importlib.import_module(name)
            missing += [] if module.__doc__ else [name]
            for what, x in vars(module).items():
                if what[0] == '_' or getattr(x, '__module__', None) != name:
                    continue
                parts = vars(x) if inspect.isclass(x) else ()
                missing += [f'{name}.{what}.{part}' for part in parts if part[0] != '_' and not inspect.getdoc(getattr(x, part))]
                missing += [] if inspect.getdoc(x) else [f'{name}.{what}']
        self.assertEqual(missing, [])

    @unittest.skipUnless(shutil.which('stubtest'), 'needs mypy')
    def test_types(self):
        """mypy accepts the package, and its types are those of its functions."""
        with tempfile.TemporaryDirectory() as folder:
            env = {**os.environ, 'MYPYPATH': str(ROOT / 'python'), 'MYPY_CACHE_DIR': folder}
            config = str(ROOT / 'pyproject.toml')
            code, text = said('mypy', '--config-file', config, cwd=folder, env=env)
            self.assertEqual(code, 0, text)
            without_stub = pathlib.Path(folder) / 'without_stub'
            without_stub.write_text(''.join(rf'obsim\.{p.stem}(\..*)?' + '\n' for p in (ROOT / 'python/obsim').glob('*.py')), encoding='ascii')
            code, text = said('stubtest', '--mypy-config-file', config, '--allowlist', str(without_stub), '--ignore-unused-allowlist', 'obsim',
                              cwd=folder, env=env)
            self.assertEqual(code, 0, text)

    def test_wheel(self):
        """A wheel of a copy of the checkout leads a universe where nothing else of the package is."""
        if importlib.util.find_spec('hatchling') is None or importlib.util.find_spec('pip') is None:
            self.skipTest('needs hatchling and pip')
        with tempfile.TemporaryDirectory() as folder:
            checkout = pathlib.Path(folder) / 'checkout'
            shutil.copytree(ROOT / 'python', checkout / 'python', ignore=shutil.ignore_patterns('__pycache__'))
            shutil.copy(ROOT / 'pyproject.toml', checkout)
            before = sorted(checkout.rglob('*'))
            code, text = said(sys.executable, '-m', 'pip', 'wheel', '--no-deps', '--no-build-isolation', '--no-index', '-w', folder, '.', cwd=checkout)
            self.assertEqual(code, 0, text)
            self.assertEqual(sorted(checkout.rglob('*')), before) # nothing else is left there
            wheel, = pathlib.Path(folder).glob('obsim-*-py3-none-any.whl')
            with zipfile.ZipFile(wheel) as z:
                z.extractall(folder + '/installed')
                files = {name for name in z.namelist() if name.startswith('obsim/')}
            self.assertEqual(files, {'obsim/' + p.name for p in (checkout / 'python/obsim').iterdir()})
            program = 'import obsim; u = obsim.run("stack", inside=True); u.step(3); print(obsim.__file__, u.steps)'
            code, text = said(sys.executable, '-c', program, cwd=folder, env={**os.environ, 'PYTHONPATH': folder + '/installed'})
            self.assertEqual((code, text), (0, f'{folder}/installed/obsim/__init__.py 3\n'))

    def test_version(self):
        """The wheel has the version of the program."""
        code, text = said(os.environ['OBSIM'], '--version')
        self.assertEqual(code, 0)
        version, = (line for line in (ROOT / 'pyproject.toml').read_text(encoding='utf-8').splitlines() if line.startswith('version'))
        self.assertIn(version.split('"')[1], text)


if __name__ == '__main__':
    unittest.main()
