# Rows of the tables of peers.sh from its sorted lines: medians of three. part 1: packings that others ran too; part 2: the rest.
BEGIN {
  name["friction"] = "normal + tangential"
  name["cohesion"] = "+ rolling + twisting (cairn: + cohesion)"
}
{
  key = $1 " " $2 " " $3
  if (!(key in seen)) { seen[key]; order[++keys] = key }
  if (++count[key, $4] == 2) { speed[key, $4] = $5; touch[key, $4] = $6 }
}
function shown(x) { return x > 0 ? sprintf("%.1f", x) : "" }
END {
  for (k = 1; k <= keys; ++k) {
    key = order[k]
    split(key, field, " ")
    ours = speed[key, "cairn"]
    best = speed[key, "LAMMPS"] > speed[key, "LIGGGHTS"] ? speed[key, "LAMMPS"] : speed[key, "LIGGGHTS"]
    if (part == 1 && best > 0)
      printf "| %s | %s | %d | %.2f, %.2f | %s | %s | %s | %.1f |\n", field[1], name[field[2]], field[3],
        touch[key, "LAMMPS"], touch[key, "cairn"], shown(speed[key, "LAMMPS"]), shown(speed[key, "LIGGGHTS"]), shown(ours), ours / best
    if (part == 2 && !(best > 0))
      printf "| %s | %s | %d | %.2f | %s |\n", field[1], name[field[2]], field[3], touch[key, "cairn"], shown(ours)
  }
}
