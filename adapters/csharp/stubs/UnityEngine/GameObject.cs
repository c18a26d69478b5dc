using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public sealed class GameObject : Object
    {
        private readonly List<Component> _components = new List<Component>();
        private bool _active = true;

        public GameObject(string name, params Type[] components)
        {
            this.name = name;
            SceneManagement.Scene.All.Add(this);
            transform = (Transform)Add(typeof(Transform));
            foreach (Type type in components)
            {
                AddComponent(type);
            }
        }

        public Transform transform { get; private set; }

        /// <summary>Only MainCamera has an effect here.</summary>
        public string tag
        {
            set { Camera.main = value == "MainCamera" ? GetComponent<Camera>() : Camera.main; }
        }

        public bool activeSelf
        {
            get { return _active; }
        }

        public bool activeInHierarchy
        {
            get { return _active && (transform.parent == null || transform.parent.gameObject.activeInHierarchy); }
        }

        public void SetActive(bool active)
        {
            _active = active;
            ChangedBelow();
        }

        public T AddComponent<T>()
            where T : Component
        {
            return (T)AddComponent(typeof(T));
        }

        public Component AddComponent(Type type)
        {
            foreach (RequireComponent required in type.GetCustomAttributes(typeof(RequireComponent), true))
            {
                if (Find(required.Type) == null)
                {
                    AddComponent(required.Type);
                }
            }
            Component made = Add(type);
            Behaviour behaviour = made as Behaviour;
            if (behaviour is object)
            {
                behaviour.Changed();
            }
            return made;
        }

        public T GetComponent<T>()
        {
            object found = Find(typeof(T));
            return found == null ? default(T) : (T)found;
        }

        public void GetComponents<T>(List<T> results)
        {
            results.Clear();
            foreach (Component component in _components)
            {
                if (component is T)
                {
                    results.Add((T)(object)component);
                }
            }
        }

        public T[] GetComponentsInChildren<T>()
        {
            List<T> found = new List<T>();
            AddComponentsInChildren(found);
            return found.ToArray();
        }

        /// <summary>Skips inactive objects.</summary>
        internal void AddComponentsInChildren<T>(List<T> results)
        {
            for (int i = 0; i < _components.Count && _active; i++)
            {
                if (_components[i] is T)
                {
                    results.Add((T)(object)_components[i]);
                }
            }
            for (int i = 0; i < transform.Children.Count && _active; i++)
            {
                transform.Children[i].gameObject.AddComponentsInChildren(results);
            }
        }

        internal void Remove(Component component)
        {
            Behaviour behaviour = component as Behaviour;
            if (behaviour is object)
            {
                behaviour.enabled = false;
            }
            _components.Remove(component);
        }

        internal void Empty()
        {
            SetActive(false);
            foreach (Component component in _components)
            {
                component.Destroyed = true;
            }
        }

        internal void ChangedBelow()
        {
            foreach (Component component in _components.ToArray())
            {
                Behaviour behaviour = component as Behaviour;
                if (behaviour is object)
                {
                    behaviour.Changed();
                }
            }
            foreach (Transform child in transform.Children)
            {
                child.gameObject.ChangedBelow();
            }
        }

        private Component Find(Type type)
        {
            return _components.Find(type.IsInstanceOfType);
        }

        private Component Add(Type type)
        {
            Component made = (Component)Activator.CreateInstance(type);
            made.gameObject = this;
            _components.Add(made);
            return made;
        }
    }
}
