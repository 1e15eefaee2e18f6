# Plots bench/results: ns per particle and step over the history window (history.png) and over the number of particles
# (scaling.png). Make the results with
#
#   bench/tables.sh table1 history scaling
#
# and the plots, inside a checkout (Debian package gnuplot-nox), with
#
#   gnuplot bench/plots.gp
#   gnuplot -e "machine='aarch64'; folder='pictures'" bench/plots.gp    other results, another folder for the pictures
if (!exists("machine")) machine = "x86_64"
if (!exists("folder")) folder = "."
results(name) = sprintf("bench/results/%s-%s.csv", name, machine)
# Distinct values of a CSV column, in the order of the file.
each_of(name, column) = system(sprintf("awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == \"%s\") c = i; next } !seen[$c]++ { print $c }' %s", column, results(name)))

set datafile separator ","
set datafile columnheaders
set terminal pngcairo size 1200,560 font "sans,11"
set grid
set key top left
set style data linespoints
set yrange [0:*]
set autoscale xfix
set offsets graph .03, graph .03, 0, 0
set ylabel "ns per particle and step"

set output folder . "/history.png"
set multiplot layout 1,2
set xlabel "window d, steps"
set title "a step (dashed: without the stages of the history)"
plot for [scheme in each_of("table1", "scheme")] for [scene in each_of("table1", "case")] results("table1") \
         using (strcol("case") eq scene && strcol("scheme") eq scheme ? column("window") : NaN):"ns_median":"ns_least":"ns_largest" \
         with yerrorlines pointtype 7 title scene . ", " . scheme, \
     for [scheme in each_of("table1", "scheme")] for [scene in each_of("table1", "case")] results("table1") \
         using (strcol("case") eq scene && strcol("scheme") eq scheme ? column("window") : NaN):"ns_without_history" \
         with lines dashtype 2 title scene . ", " . scheme . ", without"
set title "the history's stages, by kind"
plot for [kind in each_of("history", "kind")] results("history") \
         using (strcol("kind") eq kind ? column("window") : NaN):(column("ns_fractional_derivative")) \
         pointtype 7 title kind . ": D^q" noenhanced, \
     for [kind in each_of("history", "kind")] results("history") \
         using (strcol("kind") eq kind ? column("window") : NaN):(column("ns_history")) \
         pointtype 6 dashtype 2 title kind . ": storing" noenhanced
unset multiplot

set output folder . "/scaling.png"
set multiplot layout 1,2
set logscale x
set offsets 0, 0, 0, 0
set xrange [1e4:4e6]
set xlabel "particles"
set title "a step"
plot results("scaling") using "particles":"ns_median":"ns_least":"ns_largest" with yerrorlines pointtype 7 title "whole step", \
     for [stage in "neighbours viscosity densities forces"] results("scaling") \
         using "particles":(column("ns_" . stage)) title stage noenhanced
set title "memory"
set ylabel "bytes per particle"
plot results("scaling") using "particles":"bytes_state" pointtype 7 title "state", \
     results("scaling") using "particles":"bytes_world" pointtype 7 title "all memory of the library", \
     results("scaling") using "particles":"bytes_process" pointtype 7 title "peak of the process"
unset multiplot
