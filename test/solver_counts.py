#!/usr/bin/env python3
"""What the minimal solvers execute: floating-point operations and the share of each step.

  cmake --preset release -B build/counts -DCMAKE_CXX_FLAGS=-g
  cmake --build build/counts --target kernels_benchmark
  RIGEL_BUILD_DIR=build/counts test/solver_counts.py [solver...]

Needs valgrind, objdump, addr2line and Google Benchmark. Callgrind counts how often each instruction
runs between the call of a solver and its return, on the intra-camera samples of kernels_benchmark.
Means per sample. A packed instruction counts as two operations, or four of 256 bits. The operations
within libm (sine, cosine, cube root) are among the instructions, step "other", and not among the
operations.
"""
import collections
import os
import re
import subprocess
import sys
import tempfile

SOLVERS = {
    '4pt-approx': 'Solve4ptApprox', '4pt-approx-polished': 'Solve4ptApproxPolished',
    '3pt-approx': 'Solve3ptApprox', '3pt-approx-polished': 'Solve3ptApproxPolished',
    '4pt': 'Solve4pt', '3pt': 'Solve3pt', '4pt-lee': 'Solve4ptLee', '4pt-liu': 'Solve4ptLiu',
    '4pt-sweeney': 'Solve4ptSweeney',
    '17pt-li': 'Solve17ptLi(rigel::PreparedMatches const&, int const*, int,',
    '6pt-stewenius': 'Solve6ptStewenius', '6pt-ventura': 'Solve6ptVentura',
    '5pt+1': 'Solve5ptPlusOne', '2pt-choi': 'Solve2ptChoi', '2pt-ackermann': 'Solve2ptAckermann'}
# The outermost function of an inlined chain that is listed decides.
STEPS = [
    ('motions', r'AddSolution|PolishSixPoint|::Polish\(|::Add\(|AddPolished|ExpSO3|NullVector|'
                r'SolveSixBySix|EliminateColumn|SixPointStep|PivotCompletely'),
    ('roots', r'RealRoots|CubicStarts|PolishRoots|RealSolutions|RootFinder|RootsInClosedForm|'
              r'Isolated|Newton|Bracket|Hessenberg|CharacteristicPoly|SolveAll|'
              r'PrepareAvx2|PrepareBaseline'),
    ('elimination', r'Determinant|AddMinors|MakeEquations|CombineRows|MacaulayMatrix|AddProduct|'
                    r'AddBilinear|DepthRows|AddQuartics|AddSextics|Minors?\(|BringPivotTo|'
                    r'RealRotations|operator\(\)'),
    ('set-up', r'SetFourPoint|SetPlanar|SetReference|SetRow|DirectSample|SixPointSystem|MakeRow')]
OPERATIONS = [('add', r'v?(add|sub)([sp])d'), ('mul', r'v?mul([sp])d'), ('div', r'v?div([sp])d'),
              ('sqrt', r'v?sqrt([sp])d')]


def instruction_counts(path, program):
    """{address: executions} of the program itself; those of shared libraries at address -1."""
    counts = collections.Counter()
    address, calls = 0, False
    objects, own = {}, True
    for line in open(path):
        match = re.match(r'c?ob=\((\d+)\)(?: (.*))?', line)
        if match:
            if match.group(2):
                objects[match.group(1)] = os.path.basename(match.group(2).strip())
            if line[0] == 'o':
                own = objects[match.group(1)] == os.path.basename(program)
            continue
        if line.startswith('calls='):
            calls = True
            continue
        match = re.match(r'(0x[0-9a-f]+|\+\d+|-\d+|\*) (\S+) ?(\d+)?', line)
        if not match:
            continue
        word = match.group(1)
        if word[0] == '0':
            address = int(word, 16)
        elif word != '*':
            address += int(word)
        if not calls:
            counts[address if own else -1] += int(match.group(3) or 0)
        calls = False
    return counts


def disassembly(program):
    """{address: (mnemonic, doubles of a packed one)} and {function: address}."""
    code, starts = {}, {}
    out = subprocess.run(['objdump', '-dC', '--no-show-raw-insn', program], check=True,
                         capture_output=True, text=True).stdout
    for line in out.splitlines():
        match = re.match(r'([0-9a-f]+) <(.*)>:$', line)
        if match:
            starts[match.group(2)] = int(match.group(1), 16)
        match = re.match(r'\s+([0-9a-f]+):\s+(\S+)', line)
        if match:
            code[int(match.group(1), 16)] = match.group(2), 4 if '%ymm' in line else 2
    return code, starts


def steps_of(program, addresses):
    """{address: step} by the functions that were inlined there."""
    out = subprocess.run(['addr2line', '-afiC', '-e', program], check=True, capture_output=True,
                         input='\n'.join(hex(a) for a in addresses), text=True).stdout
    steps, address, names = {}, None, []

    def close():
        for name in reversed(names):
            for step, pattern in STEPS:
                if re.search(pattern, name) and 'rigel::Solve' not in name:
                    steps[address] = step
                    return

    for line in out.splitlines():
        if re.match(r'0x[0-9a-f]{16}$', line):
            close()
            address, names = int(line, 16), []
        elif not re.search(r':(\d+|\?)( \(discriminator \d+\))?$', line):
            names.append(line)
    close()
    return steps


def main():
    if any(argument.startswith('-') for argument in sys.argv[1:]):
        print(__doc__)
        sys.exit(0 if sys.argv[1] in ('-h', '--help') else 2)
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    build = os.environ.get('RIGEL_BUILD_DIR') or os.path.join(root, 'build', 'release')
    program = os.path.join(build, 'bin', 'kernels_benchmark')
    if not os.path.exists(program):
        sys.exit(f'solver_counts: there is no {program}')
    code, starts = disassembly(program)
    print('                        instruc-  flops     adds     muls   divs  sqrts '
          ' set-up  elimin.  roots motions other')
    for name in sys.argv[1:] or SOLVERS:
        function = 'rigel::' + SOLVERS[name]
        if '(' not in function:
            function += '('
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, 'callgrind')
            subprocess.run(['valgrind', '--tool=callgrind', '--dump-instr=yes',
                            '--callgrind-out-file=' + path, '--toggle-collect=' + function + '*',
                            program, '--benchmark_min_time=0.5',
                            '--benchmark_filter=^BM_Solver/%s/intra$' % name.replace('+', '[+]')],
                           check=True, capture_output=True)
            counts = instruction_counts(path, program)
        calls = max(counts[a] for f, a in starts.items() if f.startswith(function))
        steps = steps_of(program, [a for a in counts if a in code])
        shares, operations = collections.Counter(), collections.Counter()
        for address, count in counts.items():
            shares[steps.get(address, 'other')] += count
            mnemonic, packed = code.get(address, ('', 0))
            for operation, pattern in OPERATIONS:
                match = re.match(pattern + '$', mnemonic)
                if match:
                    operations[operation] += count * (packed if match.groups()[-1] == 'p' else 1)
        total = sum(counts.values())
        flops = sum(operations.values())
        print('%-22s %9.0f %7.0f ' % (name, total / calls, flops / calls) +
              ' '.join('%*.*f' % (8 if o in ('add', 'mul') else 6, 0 if flops / calls > 9999 else 1,
                                  operations[o] / calls) for o, _ in OPERATIONS) + '   ' +
              ' '.join('%6.0f%%' % (100 * shares[s] / total)
                       for s in ('set-up', 'elimination', 'roots', 'motions', 'other')))


if __name__ == '__main__':
    main()
