"""A seeded mutation campaign: damaged robots and meshes, and wrong arguments of the public functions.

`case` draws a case from a seed and a number; `mutators` damage files; `trial` tries a case; `worker` does so in a
process of its own, which `campaign` watches: what crashes it, hangs it or breaks a promise is kept, made smaller and
can be tried again. `guided` lets atheris choose the bytes.
"""
