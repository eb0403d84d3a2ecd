"""URDF with the joint types and constraints of Drake."""
