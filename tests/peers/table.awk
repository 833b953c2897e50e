# Tables of peers.sh from its lines: medians of the rounds. part 1: packings that others ran too; part 2: the rest.
BEGIN {
  name["friction"] = "normal + tangential"
  name["cohesion"] = "+ rolling + twisting (cairn: + cohesion)"
  others = split("LAMMPS native_LAMMPS LIGGGHTS", other, " ")
  ours = split(sets, set, " ")
}
{
  key = $1 " " $2 " " $3
  if (!(key in seen)) { seen[key]; order[++keys] = key }
  speeds[key, $4, ++count[key, $4]] = $5
  touch[key, $4] = $6
}
function median(key, code,   n, j, k, x) {
  n = count[key, code]
  for (j = 2; j <= n; ++j)
    for (k = j; k > 1 && speeds[key, code, k] < speeds[key, code, k - 1]; --k) {
      x = speeds[key, code, k]; speeds[key, code, k] = speeds[key, code, k - 1]; speeds[key, code, k - 1] = x
    }
  return n ? speeds[key, code, int((n + 1) / 2)] + 0 : 0
}
function cell(x) { return x > 0 ? sprintf(" %.1f |", x) : " |" }
function rule(n,   k, out) { out = "|"; for (k = 0; k < n; ++k) out = out "---|"; return out }
END {
  head = "| packing | physics | cores | contacts per sphere |"
  if (part == 1) {
    head = "| packing | physics | cores | contacts per sphere: LAMMPS, cairn | LAMMPS | LAMMPS, native | LIGGGHTS |"
    for (k = 1; k <= ours; ++k) head = head " cairn, " set[k] " |"
    print head " ratios to the best of them |"
    print rule(8 + ours)
  } else {
    print head " cairn |"
    print rule(5)
  }
  for (n = 1; n <= keys; ++n) {
    key = order[n]
    split(key, field, " ")
    best = 0
    for (k = 1; k <= others; ++k) if (median(key, other[k]) > best) best = median(key, other[k])
    if ((part == 1) != (best > 0)) continue
    line = "| " field[1] " | " name[field[2]] " | " field[3] " |"
    if (part == 2) {
      print line sprintf(" %.2f |", touch[key, set[1]]) cell(median(key, set[1]))
      continue
    }
    line = line sprintf(" %.2f, %.2f |", touch[key, "LAMMPS"], touch[key, set[1]])
    for (k = 1; k <= others; ++k) line = line cell(median(key, other[k]))
    ratios = ""
    for (k = 1; k <= ours; ++k) {
      line = line cell(median(key, set[k]))
      ratios = ratios (k > 1 ? ", " : " ") sprintf("%.1f", median(key, set[k]) / best)
    }
    print line ratios " |"
  }
}
