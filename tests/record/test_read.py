#!/usr/bin/env python3
"""test_read.py PROGRAM: h5py reads the records of PROGRAM as documented. Exit 77 (skipped) without h5py."""
import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy
except ImportError:
    print('python3-h5py is not installed')
    sys.exit(77)

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, 'record.h5')
    subprocess.run([sys.argv[1], path], check=True)
    with h5py.File(path, 'r') as f:
        n, objects = len(f['time']), len(f['objects/id'])
        assert f['position'].shape == (n, objects, 3), f['position'].shape
        assert f['attitude'].shape == (n, objects, 4), f['attitude'].shape
        assert f.attrs['format'] == b'obsim record' and f.attrs['format_version'] == 2 and f.attrs['seed'] == 5
        assert f['scene'][()] == b'box {}' and f['parameters'][()] == b'n=3\n'
        assert f['cameras']['name'].tolist() == [b'main', b'other'] and f['look']['grid'].tolist() == [1]
        events = f['events'][:]
        assert events['kind'].tolist() == [1, 1, 1] and events['step'].tolist() == [0, 0, 5], events
        assert events['size'][2].tolist() == [.1, .2, .3] and events['name'][0] == b'ground'
        last = f['motions'][:f['motions_until'][9]]
        last = last[last['id'] == 1][-1]
        assert last['p'].tolist() == [1, 2, 9] and last['t0'] == f['time'][9]
        assert f.attrs['title'] == b'A title', f.attrs['title']
        assert list(f.attrs['gravity']) == [0, 0, -9.81]
        assert f['velocity'].attrs['units'] == b'm/s'
        assert list(f['objects/name']) == [b'ground', b'box', b'box']
        assert f['position'][9, 1].tolist() == [1, 2, 9]
        assert numpy.isnan(f['position'][4, 2]).all() and not numpy.isnan(f['position'][5, 2]).any()
        for name in f:
            if isinstance(f[name], h5py.Dataset):
                assert {'units', 'description'} <= set(f[name].attrs), name
print('read by h5py', h5py.__version__)
