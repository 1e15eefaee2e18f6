"""api.py XML: reads the reference that doxygen made as XML, and prints each public declaration that it does not document, with its
header: functions, macros, types, enumerators and members. An enumerator that a list of rows makes is documented where the text of its
type names it. A function that can fail must say how: it names results, or a function that has the same. The last line is the number
of declarations."""
import glob
import os
import sys
import xml.etree.ElementTree as tree


def text(element, *names):
    return ' '.join(' '.join(''.join(part.itertext()) for part in element.findall(name)) for name in names).strip()


def main(folder):
    count = 0
    general = {}  # what the comment of a header says for all its functions
    roots = [tree.parse(name).getroot() for name in sorted(glob.glob(os.path.join(folder, '*.xml')))]
    compounds = [c for root in roots for c in root.findall('compounddef')]
    for compound in compounds:
        if compound.get('kind') == 'file':
            general[compound.findtext('compoundname')] = text(compound, 'briefdescription', 'detaileddescription')
    for compound in compounds:
        kind, name = compound.get('kind'), compound.findtext('compoundname')
        if kind not in ('file', 'struct', 'union') or name.endswith('.md'):
            continue
        count += 1
        if not text(compound, 'briefdescription', 'detaileddescription') and '@' not in name:
            print(name, 'is not documented')
        for member in compound.iter('memberdef'):
            own = member.findtext('name')
            if own.startswith('RHEO__') or own.startswith('RHEOLOG_'):
                continue
            words = text(member, 'briefdescription', 'detaileddescription')
            count += 1
            where = name if kind == 'file' else f'{name}.'
            if not words:
                print(where, own or member.get('kind'), 'is not documented')
            values = member.findall('enumvalue')
            for value in values:
                count += 1
                if len(values) == 1:
                    continue  # what the type says is about it
                if not text(value, 'briefdescription', 'detaileddescription') and value.findtext('name') not in words:
                    print(where, value.findtext('name'), 'is not documented')
            if member.get('kind') == 'function' and text(member, 'type') == 'rheo_result':
                if 'RHEO_ERROR' not in words and 'rheo_' not in words and 'RHEO_ERROR' not in general[name]:
                    print(where, own, 'does not say how it fails')
    print(count)


main(sys.argv[1])
