#!/usr/bin/env python3
"""check_files.py WRITER: the files of WRITER are well-formed XML and PNG, and the same in every run and locale."""
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
import zlib


def written(writer, locale):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([writer, folder], check=True, env={**os.environ, 'LC_ALL': locale})
        return {path.name: path.read_bytes() for path in sorted(pathlib.Path(folder).iterdir())}


def check_svg(name, data):
    root = xml.etree.ElementTree.fromstring(data.decode('utf-8'))
    assert root.tag == '{http://www.w3.org/2000/svg}svg', name
    for text in root.iter('{http://www.w3.org/2000/svg}text'):
        assert ''.join(text.itertext()).strip() or text.text, name
        assert not {'textLength', 'lengthAdjust'} & set(text.attrib), f'{name}: a text that another font would squeeze'
    assert b'nan' not in data.lower().replace(b'donau', b'') and b'inf"' not in data, name


def check_png(name, data):
    assert data[:8] == b'\x89PNG\r\n\x1a\n', name
    at, pixels, kinds = 8, b'', []
    while at < len(data):
        length, kind = struct.unpack('>I4s', data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + body) == struct.unpack('>I', data[at + 8 + length:at + 12 + length])[0], name
        kinds.append(kind)
        pixels += body if kind == b'IDAT' else b''
        if kind == b'IHDR':
            width, height = struct.unpack('>II', body[:8])
        at += 12 + length
    assert kinds[-1] == b'IEND' and width >= 240 and height >= 130, name
    raw = zlib.decompress(pixels)
    assert len(raw) == height * (1 + 3 * width), name
    assert len(set(raw)) > 10, f'{name}: nothing is drawn'


def main():
    first, second = written(sys.argv[1], 'C'), written(sys.argv[1], 'de_DE.UTF-8')
    assert first == second, 'not the same bytes'
    for name, data in first.items():
        (check_svg if name.endswith('.svg') else check_png)(name, data)
    print(f'{len(first)} files')
    assert len(first) == 62


main()
